"""Walking on legs without a motor, with analytic truth: the rimless wheel, single strides, and the compass gait."""
