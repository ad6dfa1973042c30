"""What people read and send on: text, figures, report, scene, exchange."""
