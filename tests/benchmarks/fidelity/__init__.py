"""How close the drawn strokes come to strokes that are known: sets, metrics, bars, and other tracers beside ours."""
