"""The required content of package.xml and CMakeLists.txt, from what the launch files of a package use."""
