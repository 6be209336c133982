"""Hide a cause, find it: an independent sweep generator, its scoring and the study that runs both.

Nothing in here, the tests apart, uses the simulator or the diagnoser of the project: every cause is
written a second time, from its definition, so that a mistake in one is not repeated in the other.
"""
