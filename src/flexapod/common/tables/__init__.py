"""Tables of a study file, whatever is in them: reading, refusing, writing; what the model and its elements share."""
