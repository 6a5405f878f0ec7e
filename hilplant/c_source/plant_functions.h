/* A bench: its parameters (HILPLANT_PARAMETERS of them, then the numbers of its networks, if it has any), and its
 * tables over the crank angle, [knots, channels, 2] in row-major order. */
typedef struct {
    const double *parameters;
    int64_t parameter_count;
    const double *tables;
    int64_t knots;
    int64_t channels;
} hilplant_plant;

/* One tick: `outputs` are filled with what is seen at its start, and `state` moves on to its end. */
void hilplant_tick(const hilplant_plant *plant, double *state, const double *inputs, double *outputs);

/* Many ticks: a row of inputs and a row of outputs for each. */
void hilplant_simulate(const hilplant_plant *plant, double *state, int64_t ticks, const double *inputs, double *outputs);
