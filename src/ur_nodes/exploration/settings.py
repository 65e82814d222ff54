"""The parameters of `explore`, under upstream's names where there is one, read once and checked."""

from dataclasses import dataclass

from ur_nodes.costmap.local_costmap_settings import read_footprint
from ur_nodes.exploration.explorer_step import ExplorerSettings
from ur_nodes.exploration.search.choice import CornerSettings, Weights
from ur_nodes.ports.parameters import Parameters


@dataclass(frozen=True, slots=True)
class ExploreSettings:
    """`period`: s between two decisions. `quiet`: s without another driver before it goes on.

    `save_service` saves the map and answers its name; '' where it is not saved. `navigation` is the node with the
    action, `costmap` the topic of its global costmap, `costmap_updates` that of the cells that changed.
    """

    explorer: ExplorerSettings
    period: float
    quiet: float
    base_frame: str
    map_frame: str
    navigation: str
    costmap: str
    costmap_updates: str
    mux: str
    save_service: str


def read_settings(own: Parameters) -> ExploreSettings:
    """Read them all. Raises UserError, which names the parameter."""
    navigation = own.text("navigation", "move_base")
    footprint = read_footprint(own.of(navigation).below("global_costmap"), 0.05)
    return ExploreSettings(
        explorer=ExplorerSettings(
            radius=footprint.inscribed,
            room=footprint.circumscribed,
            smallest_frontier=own.number("min_frontier_size", 0.3, minimum=0.05, maximum=10.0, live="least width, m"),
            progress_timeout=own.number("progress_timeout", 30.0, minimum=1.0, maximum=3600.0, live="s until failure"),
            patience=own.number("patience", 15.0, minimum=0.0, maximum=3600.0, live="s without goals until the end"),
            corners=CornerSettings() if not own.boolean("explore_corners", False) else CornerSettings(left_out=0.0),
            weights=Weights(
                distance=own.number("potential_scale", 1.0, minimum=0.0, maximum=1e3, live="weight of the way"),
                gain=own.number("gain_scale", 0.1, minimum=0.0, maximum=1e3, live="weight of a frontier's width"),
            ),
        ),
        period=1.0 / own.number("planner_frequency", 1.0, minimum=0.05, maximum=10.0, live="rate of decisions, Hz"),
        quiet=own.number("resume_after", 5.0, minimum=0.0, maximum=3600.0),
        base_frame=own.text("robot_base_frame", "base_footprint"),
        map_frame=own.text("global_frame", "map"),
        navigation=navigation,
        costmap=own.text("costmap_topic", f"{navigation}/global_costmap/costmap"),
        costmap_updates=own.text("costmap_updates_topic", f"{navigation}/global_costmap/costmap_updates"),
        mux=own.text("mux", "cmd_vel_mux"),
        save_service=own.text("save_service", ""),
    )
