"""The page in which a scene is simulated while one looks at it."""
