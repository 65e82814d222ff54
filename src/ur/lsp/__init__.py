"""The language server: answers about launch files in an editor, from what `ur check`, `find` and `explain` know.

`workspace` holds the texts and findings; the modules beside it are functions of it and a place; `server` and
`serve` speak the protocol.
"""
