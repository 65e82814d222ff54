"""A map that is published once, followed by updates of changed cells, such as a costmap of the navigation."""

from dataclasses import replace

from ur_nodes.ports.values import Map, MapUpdate


class KeptMap:
    """The map with all changes so far; the cells are its own, and change with each update."""

    def __init__(self) -> None:
        self.map: Map | None = None

    def replace(self, given: Map) -> None:
        """Replace the map."""
        self.map = replace(given, grid=replace(given.grid, values=given.grid.values.copy()))

    def apply(self, update: MapUpdate) -> str:
        """Apply an update if there is a map; return what is wrong with it, or ''.

        After a change of the map's size, updates may not fit until the new map arrives.
        """
        if self.map is None:
            return ""
        values, (rows, columns) = self.map.grid.values, update.values.shape
        height, width = values.shape
        fits = update.row + rows <= height and update.column + columns <= width
        if not fits or update.row < 0 or update.column < 0:
            return (
                f"update of {columns} x {rows} cells at ({update.column}, {update.row}), "
                f"expected cells inside the grid of {width} x {height}"
            )
        values[update.row : update.row + rows, update.column : update.column + columns] = update.values
        return ""
