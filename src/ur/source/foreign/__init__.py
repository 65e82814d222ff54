"""The only reader of untrusted files: it limits special files, sizes, nesting and counts.

`files` opens them, `yaml_text` and `xml_text` read what they hold, `pictures` unpacks them.
"""
