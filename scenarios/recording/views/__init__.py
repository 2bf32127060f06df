"""What a recording shows: the scene, the plots, the timeline, the summary, and how they are laid out."""
