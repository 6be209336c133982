"""halltwin bench: stepper, reference encoder, Hall encoder and climate chamber on a CAN bus, virtual or real."""
