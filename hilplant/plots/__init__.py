"""Every picture that hilplant draws; the only room that imports matplotlib."""
