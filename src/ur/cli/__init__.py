"""The command line: a package for each group of verbs, whose modules are imported when a verb is used."""
