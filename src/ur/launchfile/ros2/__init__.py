"""Launch files of ROS 2: XML, YAML and Python, read into one description, and the description into a Plan.

    text -> description (entities of the launch API, each with its position) -> Plan

`api` has the classes of the launch API and what they accept; `python` reads Python files without running them.
"""
