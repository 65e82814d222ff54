"""The one reader of files that other people have made: special files, sizes, nesting and counts are limited here.

`files` opens them, `yaml_text` and `xml_text` read what they hold, `pictures` unpacks them.
"""
