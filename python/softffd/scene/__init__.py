"""The scene: a TOML file, validated."""
