"""Ray diagrams: the paths of single rays through a scene, seen from one side."""
