"""Pure scalar physics, compiled: functions of (state, inputs, parameters) that store nothing."""
