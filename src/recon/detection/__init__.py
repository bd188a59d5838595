"""Where the ground lies in shade: frames on the ground in, shade maps out."""
