"""A log without a reference: the shaft's motion, estimated from the sensor's readings together with their errors."""
