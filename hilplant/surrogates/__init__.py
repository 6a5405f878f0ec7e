"""Networks in place of physics: their evaluation in compiled code; they are trained in hilplant/train."""
