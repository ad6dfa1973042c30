"""Output for people and other programs: text, figures, report, scene, exchange."""
