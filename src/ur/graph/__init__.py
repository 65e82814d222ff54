"""Pictures of launch files and of running nodes: trees and graphs, and their output formats."""
