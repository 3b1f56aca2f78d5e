"""The page in which a scene is simulated while the user looks at it."""
