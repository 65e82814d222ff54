"""Queries about a plan."""

from ur.launchfile.plan.names import join_names
from ur.launchfile.plan.specs import Plan
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean


def list_nodes(plan: Plan) -> list[str]:
    """Answer `--nodes`: full names of nodes and tests, in document order, nodes first; nameless ones are left out."""
    return [node.full_name for node in plan.all_nodes() if node.name]


def list_files(plan: Plan) -> list[str]:
    """Answer `--files`: every launch file read, sorted; roslaunch prints them in no order."""
    return sorted(plan.files)


def find_node_file(plan: Plan, name: str) -> str:
    """Answer `--find-node NAME`: the launch file that defines a node. Raises UserError if there is none."""
    full_name = join_names("/", name)
    for node in plan.all_nodes():
        if node.name and node.full_name == full_name:
            return node.origin.span.file.path
    names = list_nodes(plan)
    near = did_you_mean(full_name, names)
    raise UserError(
        error(
            f"unknown node '{full_name}', expected one of {', '.join(names) or 'none'}",
            rule="unknown-node",
            help=f"did you mean {near}?" if near else None,
            subject=full_name,
        )
    )


def dump_params(plan: Plan) -> str:
    """Answer `--dump-params`: every parameter as YAML, as roslaunch prints it. Commands have to be run before."""
    import yaml

    return str(yaml.safe_dump({param.name: param.value for param in plan.params})) + "\n"
