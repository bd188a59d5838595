"""Which orders only stop: what is asked of motion is not asked of them."""

from recon.model.command import Body, VirtualStick


def is_zero_stick(body: Body) -> bool:
    """Return whether a body is a stick without velocity.

    It ends a stick before it: it stops the aircraft over the ground, and its height was judged
    when that stick was.
    """
    if not isinstance(body, VirtualStick):
        return False
    return body.velocity_x_mps == 0.0 and body.velocity_y_mps == 0.0
