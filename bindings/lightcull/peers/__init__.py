"""Other renderers, of which the same scene is shown, for comparison."""
