"""The JSON schema of the scene file."""

from typing import Any

from softffd.scene.keys import SceneKeys


def schema() -> dict[str, Any]:
    """The JSON schema of the scene file, for editors that complete and check TOML."""
    head = {"$schema": "http://json-schema.org/draft-07/schema#"}
    about = {
        "title": "softffd scene",
        "description": "A soft object, what acts on it and what is wanted of it.",
    }
    return head | _without_null(SceneKeys.model_json_schema()) | about


def _without_null(node: Any) -> Any:
    """A schema without `null`, which TOML does not have: an absent key is simply not there."""
    if isinstance(node, list):
        return [_without_null(entry) for entry in node]
    if not isinstance(node, dict):
        return node
    rest = {name: _without_null(value) for name, value in node.items() if value is not None}
    arms = [arm for arm in rest.pop("anyOf", []) if arm != {"type": "null"}]
    return rest | (arms[0] if len(arms) == 1 else {"anyOf": arms} if arms else {})
