/* The whole step of the plant by hand, in C11: the yardstick for the compiled Python in hilplant/models.
 *
 * Equations, order and names as in hilplant/models/plant.py, where they are explained. Kept equal to it by
 * tests/oracle/test_plant_in_c.py; nothing else uses it. The loads are none, polynomial and reduced and the motor is
 * the physical one: what networks would remember and show is 0.
 */
#include <string.h>

#include "shaft.h"

enum { KNOWN_OUTPUTS = 23 };

/* How many there are of each; rows may be wider than what is known here. */
typedef struct { long sets, ticks, knots, channels, state_width, input_width, parameter_width, output_width; } Shape;

static inline double finite_or_0(double value) { return isfinite(value) ? value : 0.0; }

static inline double spoilt_state(const State *state)
{
    return 0.0 * state->current + 0.0 * state->speed + 0.0 * state->angle;
}

static inline double spoilt_inputs(const Inputs *in)
{
    double zero = 0.0 * in->relay_on + 0.0 * in->relay_fast + 0.0 * in->supply + 0.0 * in->screen;
    zero += 0.0 * in->vehicle_speed + 0.0 * in->brake + 0.0 * in->left_screen + 0.0 * in->right_screen;
    return zero + 0.0 * in->left_wear + 0.0 * in->right_wear + 0.0 * in->left_force + 0.0 * in->right_force;
}

static void make_safe(State *state, Inputs *in)
{
    *state = (State){0.0, 0.0, finite_or_0(state->angle), finite_or_0(state->contact), finite_or_0(state->bounce_left),
                     1.0, finite_or_0(state->park_phase)};
    *in = (Inputs){0.0, 0.0, finite_or_0(in->supply), finite_or_0(in->screen), finite_or_0(in->vehicle_speed), 0.0,
                   finite_or_0(in->left_screen), finite_or_0(in->right_screen), finite_or_0(in->left_wear),
                   finite_or_0(in->right_wear), finite_or_0(in->left_force), finite_or_0(in->right_force)};
}

static inline double without_denormals(double value) { return fabs(value) < 1e-30 ? 0.0 : value; }

static inline void measure(Motion motion, const Place *at, const Resistance *load, double shown, const State *state,
                           const Train *train, double *out)
{
    const Parameters *p = train->p;
    const Inputs *in = train->in;
    const Connection *connection = train->connection;
    const double crank_speed = motion.speed / p->motor.ratio;
    const double left = value(at, LEFT_ROCKER), right = value(at, RIGHT_ROCKER);
    out[0] = in->supply;
    out[1] = connection->terminal;
    out[2] = motion.current;
    out[3] = motion.speed;
    out[4] = crank_speed;
    out[5] = state->angle;
    out[6] = load_torque(motion, load, train);
    out[7] = shown;
    out[8] = left + p->left_arm.offset;
    out[9] = right + p->right_arm.offset;
    out[10] = left;
    out[11] = right;
    out[12] = p->left_arm.length * derivative(at, LEFT_ROCKER) * crank_speed;
    out[13] = p->right_arm.length * derivative(at, RIGHT_ROCKER) * crank_speed;
    out[14] = in->relay_on;
    out[15] = in->relay_fast;
    out[16] = state->guard;
    out[17] = connection->v53;
    out[18] = connection->v53b;
    out[19] = connection->v53e;
    out[20] = connection->v31;
    out[21] = left_pressing(at, &p->load, in).force;
    out[22] = right_pressing(at, &p->load, in).force;
}

static inline void step(State *state, Inputs in, const Parameters *p, const Table *table, double *out)
{
    if (!(spoilt_state(state) + spoilt_inputs(&in) == 0.0 && state->guard == 0.0)) make_safe(state, &in);
    const double angle = state->angle, speed = state->speed / p->motor.ratio;
    const Contact contact = contact_now(state, &p->park_switch);
    const double phase = next_phase(&in, &p->park_switch, contact, state);
    const Connection connection = connect_motor(&in, p, contact, phase, state);
    const Motion start = {connection.closed ? state->current : 0.0, state->speed, 0.0};
    const Train train = {&connection, table, &in, p};
    const Place at = find(table, angle);
    const Resistance load
        = p->load.model == REDUCED ? reduced(&at, speed, &p->load, &in) : by_speed(angle, speed, &p->load, &in);
    measure(start, &at, &load, contact.shown, state, &train, out);
    const Motion end = turn(start, angle, &load, &train);
    *state = (State){without_denormals(end.current), without_denormals(end.speed),
                     within_turn(angle + end.turned / p->motor.ratio), contact.closed, contact.bounce_left, state->guard,
                     phase};
    if (spoilt_state(state) == 0.0 && state->guard == 0.0) return;
    state->current = state->speed = 0.0;
    state->angle = angle;
    state->guard = 1.0;
}

/* One set: all outputs of each tick, or those whose places are in `columns`. */
static void run(double *state_row, const double *inputs, const double *parameter_row, const Table *table,
                double *outputs, const Shape *shape, const long *columns)
{
    Parameters parameters;
    State state;
    Inputs in;
    double shown[KNOWN_OUTPUTS];
    memcpy(&parameters, parameter_row, sizeof parameters);
    memcpy(&state, state_row, sizeof state);
    for (long tick = 0; tick < shape->ticks; ++tick) {
        double *row = outputs + tick * shape->output_width;
        memcpy(&in, inputs + tick * shape->input_width, sizeof in);
        step(&state, in, &parameters, table, columns ? shown : row);
        for (long k = 0; columns && k < shape->output_width; ++k) row[k] = shown[columns[k]];
        for (long k = KNOWN_OUTPUTS; !columns && k < shape->output_width; ++k) row[k] = 0.0;
    }
    memset(state_row, 0, shape->state_width * sizeof *state_row);
    memcpy(state_row, &state, sizeof state);
}

void simulate_rows(double *state, const double *inputs, const double *parameters, const double *table, double *outputs,
                   const Shape *shape)
{
    run(state, inputs, parameters, &(Table){table, shape->knots, shape->channels}, outputs, shape, NULL);
}

/* Many sets with the same inputs and table, on all processors where this is compiled with OpenMP. */
void simulate_batch(double *states, const double *inputs, const double *parameters, const double *table,
                    double *outputs, const Shape *shape, const long *columns)
{
    const Table of_all = {table, shape->knots, shape->channels};
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic)
#endif
    for (long set = 0; set < shape->sets; ++set)
        run(states + set * shape->state_width, inputs, parameters + set * shape->parameter_width, &of_all,
            outputs + set * shape->ticks * shape->output_width, shape, columns);
}
