"""Unpack compressed pictures: the stand-in for image_transport's republish, for `compressed in:=A raw out:=B`."""

import sys
from collections.abc import Sequence

from ur.source.diagnostic import user_error
from ur_nodes.pictures.decode import BadPictureError, decode_picture, make_picture
from ur_nodes.ports.newest_work import NewestWork
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.values import PackedPicture, Picture
from ur_nodes.run import own_arguments, run

_EXPECTED = ["compressed", "raw"]
_LOOK_EVERY = 0.2  # s between two looks for subscribers


class Republisher:
    """Publishes `out` from `in/compressed`; subscribes only while it has subscribers."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._source = node.resolve("in") + "/compressed"
        self._subscription: Subscription | None = None
        self._publisher = node.publish("out", Picture)
        self._work = NewestWork(node, "pictures", _unpack, self._send)
        node.every(_LOOK_EVERY, self._look, steady=True)

    def _look(self) -> None:
        wanted = self._publisher.subscribers() > 0
        if wanted and self._subscription is None:
            self._subscription = self._node.subscribe(self._source, PackedPicture, self._work.ask)
        elif self._subscription is not None and not wanted:
            self._subscription.close()
            self._subscription = None

    def _send(self, _packed: PackedPicture, picture: Picture | BadPictureError) -> None:
        if isinstance(picture, BadPictureError):
            self._node.log.warn(f"{self._source}: {picture}", every=10.0)
        else:
            self._publisher.send(picture)


def _unpack(packed: PackedPicture) -> Picture | BadPictureError:
    try:
        return make_picture(decode_picture(packed.data), packed.stamp, packed.frame)
    except BadPictureError as problem:
        return problem


def start(node: Node, argv: Sequence[str] | None = None) -> Republisher:
    """Check the arguments, those of the process by default, and begin. Raises UserError."""
    given = own_arguments(sys.argv[1:] if argv is None else argv)
    if given != _EXPECTED:
        help_ = "image_transport's own republish knows other transports: n_image_uncompress, image_uncompress_pkg"
        reason = f"arguments: {' '.join(given) or 'nothing'}, expected {' '.join(_EXPECTED)}"
        raise user_error(reason, rule="bad-argument", help=help_)
    return Republisher(node)


if __name__ == "__main__":
    sys.exit(run("image_republisher", start))
