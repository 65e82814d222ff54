"""The layout of the interface, as Textual's CSS; colours are `ur.tui.palette`."""

CSS = """
Screen { layout: vertical; }
#head { height: 1; padding: 0 1; }
#nodes { scrollbar-size-vertical: 1; overflow-x: hidden; }
#rule { height: 1; }
#log { height: 1fr; scrollbar-size-vertical: 1; overflow-x: hidden; overflow-y: scroll; }
#find { height: 1; border: none; padding: 0 1; display: none; }
#foot { height: 1; padding: 0 1; }
.dialog { align: center middle; }
.dialog > Vertical { width: auto; max-width: 100%; height: auto; max-height: 100%; padding: 0 2; overflow-y: auto; }
.dialog Static { width: auto; max-width: 100%; }
.page { align: center middle; }
.page > Vertical { width: 94%; height: 94%; padding: 0 2; }
.page VerticalScroll { height: 1fr; scrollbar-size-vertical: 1; }
"""
