/* The step of the plant with networks by hand, in C11: the yardstick for benches with a torque or a motor network.
 *
 * hilplant/models/torque_network.py, hilplant/models/narx.py and hilplant/models/motor_choice.py tell what is
 * done and why; the physical models, which stand by, are those of step.c. `networks` is the row behind the parameters.
 */
#include "step.c"

enum { PARAMETERS = 48, MOTOR_MODEL_AT = 47, NETWORK_LOAD = 3 };
enum { BY_PHYSICS, BY_NETWORK, AT_STANDSTILL, OUTSIDE_TRAINING };
enum { T_NEURONS = 1, T_LOWEST, T_HIGHEST, T_MARGIN, T_DRY, T_WET, T_FIRST, T_NEURON = 9 };
enum { M_HEAD = 11, M_NEURON = 11, NO_BRUSH = 0, SLOW_BRUSH, FAST_BRUSH };
static const double RETURN_MARGIN = 0.02, ROUNDING = 1e-6;

typedef struct { double terminal, torque, current, speed, brush, mode; } Memory;
typedef struct { State plant; Memory memory; double load_mode; } Whole;
typedef struct { double angle, speed, torque, by_angle, by_speed; } Tangent;
typedef struct { const Train *train; const double *networks; int motor_network; double load_mode; Tangent tangent; } Mover;
typedef struct { double terminal, torque, current, speed; } Sample;
typedef struct { double current, speed, current_by_torque, speed_by_torque; } Prediction;
_Static_assert(sizeof(Whole) == 14 * sizeof(double), "the state as records.py packs it");

static inline Tangent network_torque(const double *n, double angle, double speed, int wet)
{
    const double s = sin(angle), c = cos(angle), s2 = 2.0 * s * c, c2 = 1.0 - 2.0 * s * s;
    Tangent sum = {angle, speed, wet ? n[T_WET] : n[T_DRY], 0.0, 0.0};
    const double *at = n + T_FIRST;
    for (int k = (int)n[T_NEURONS]; k > 0; --k, at += T_NEURON) {
        double bent = at[0] * angle + at[5] * speed + at[6];
        bent += at[1] * s + at[2] * c;
        bent += at[3] * s2 + at[4] * c2;
        double turned = at[0] + at[1] * c - at[2] * s;
        turned += 2.0 * (at[3] * c2 - at[4] * s2);
        const double share = 1.0 / (1.0 + exp(bent)), part = at[wet ? 8 : 7] * share, slope = part * (share - 1.0);
        sum.torque += part;
        sum.by_angle += slope * turned;
        sum.by_speed += slope * at[5];
    }
    return sum;
}

static inline int in_training(const Inputs *in)
{
    const double screen = in->screen;
    return (screen == 0.0 || screen == 1.0) && (in->left_screen < 0.0 || in->left_screen == screen)
        && (in->right_screen < 0.0 || in->right_screen == screen) && in->brake == 0.0 && in->vehicle_speed == 0.0
        && in->left_wear == 1.0 && in->right_wear == 1.0 && in->left_force == 1.0 && in->right_force == 1.0;
}

static inline double load_in_charge(const double *n, double speed, const Inputs *in, double before)
{
    const double margin = before == BY_NETWORK ? 0.0 : n[T_MARGIN];
    if (!in_training(in)) return OUTSIDE_TRAINING;
    if (!(speed >= n[T_LOWEST] + margin)) return AT_STANDSTILL;
    return speed <= n[T_HIGHEST] - margin ? BY_NETWORK : OUTSIDE_TRAINING;
}

static inline Resistance resist_as(const Mover *m, const Place *at, double angle, double speed)
{
    const Load *load = &m->train->p->load;
    if (m->load_mode == BY_NETWORK && m->networks[T_LOWEST] <= speed && speed <= m->networks[T_HIGHEST]) {
        const Tangent *t = &m->tangent;
        double on = angle - t->angle;
        if (on < -0.5 * TURN) on += TURN;
        const double torque = t->torque + t->by_angle * on + t->by_speed * (speed - t->speed);
        return (Resistance){value(at, INERTIA), torque, 0.0, 0.0};
    }
    if (load->model >= REDUCED) return reduced(at, speed, load, m->train->in);
    return by_speed(angle, speed, load, m->train->in);
}

/* As turn() of shaft.h, with the load of whoever is in charge. */
static inline Motion turn_whole(Motion motion, double angle, const Resistance *at_start, const Mover *m)
{
    const Train *train = m->train;
    const Parameters *p = train->p;
    if (p->load.model < REDUCED) return turn(motion, angle, at_start, train);
    const double ratio = p->motor.ratio;
    double left = p->step, direction = 0.0;
    Drive drive = through_gear(at_start, copysign(1.0, motion.speed), motion, train);
    if (motion.speed == 0.0) left -= let_go(&motion, &drive, at_start, left, &direction, &p->motor);
    for (int k = 0; k < SHAFT_STRETCHES; ++k) {
        if (left <= 0.0) return motion;
        if (motion.speed != 0.0) direction = copysign(1.0, motion.speed);
        const Ahead ahead = look_ahead(motion, &drive, direction, left, p);
        const double there = within_turn(angle + ahead.half_way.turned / ratio);
        const Place at = find(train->table, there);
        const Resistance load = resist_as(m, &at, there, ahead.half_way.speed / ratio);
        if (direction == 0.0) {
            left -= let_go(&motion, &drive, &load, left, &direction, &p->motor);
        } else {
            drive = through_gear(&load, direction, ahead.half_way, train);
            left -= slide(&motion, &drive, direction, fmin(ahead.stretch, half_period(&drive)));
            direction = 0.0;
        }
    }
    return stand(motion, &drive, left);
}

static inline Prediction predict(const double *path, const Sample *now, const Sample *before)
{
    Prediction sum = {path[9], path[10], 0.0, 0.0};
    const double *at = path + M_HEAD;
    for (int k = (int)path[0]; k > 0; --k, at += M_NEURON) {
        const double one = at[0] + at[1] * now->terminal + at[2] * now->torque;
        const double two = at[3] * now->current + at[4] * now->speed;
        const double three = at[5] * before->terminal + at[6] * before->torque;
        const double four = at[7] * before->current + at[8] * before->speed;
        const double output = 1.0 / (1.0 + exp((one + two) + (three + four)));
        const double slope = output * (output - 1.0) * at[2];
        sum.current += at[9] * output;
        sum.speed += at[10] * output;
        sum.current_by_torque += at[9] * slope;
        sum.speed_by_torque += at[10] * slope;
    }
    return sum;
}

static inline int inside(const double *low, double number, double margin)
{
    const double kept = margin * (low[4] - low[0]), lowest = low[0] == 0.0 ? low[0] - ROUNDING : low[0] + kept;
    return lowest <= number && number <= low[4] - kept;
}

static inline int within(const double *path, const Sample *s, double margin)
{
    return inside(path + 1, s->terminal, margin) && inside(path + 2, s->torque, margin)
        && inside(path + 3, s->current, margin) && inside(path + 4, s->speed, margin);
}

static inline int brush_of(const Train *train)
{
    const Brush *brush = train->connection->brush, *fast = &train->p->motor.fast;
    if (!train->connection->closed) return NO_BRUSH;
    return brush->constant == fast->constant && brush->resistance == fast->resistance
            && brush->inductance == fast->inductance ? FAST_BRUSH : SLOW_BRUSH;
}

static inline const double *path_of(const double *networks, int brush)
{
    const double *slow = networks + 1 + (int)networks[0];
    return brush == SLOW_BRUSH ? slow : slow + M_HEAD + M_NEURON * (int)slow[0];
}

static inline Motion coupled(const double *path, Sample *now, const Sample *before, const Resistance *load,
                             const Train *train)
{
    const Motor *motor = &train->p->motor;
    const double ratio = motor->ratio, step = train->p->step, speed = now->speed;
    const Prediction answer = predict(path, now, before);
    const Motion half_way = {0.5 * (now->current + answer.current), 0.5 * ratio * (speed + answer.speed), 0.0};
    const Drive drive = through_gear(load, 1.0, half_way, train);
    const double inertia = (drive.inertia - motor->inertia) * ratio * ratio / step;
    const double damping = (drive.damping - motor->damping) * ratio * ratio;
    const double by_speed = inertia + 0.5 * damping;
    const double at_zero = (drive.dry - motor->coulomb) * ratio + (0.5 * damping - inertia) * speed;
    double final = answer.speed + answer.speed_by_torque * (at_zero - now->torque);
    final /= 1.0 - answer.speed_by_torque * by_speed;
    const double torque = at_zero + by_speed * final;
    const double current = answer.current + answer.current_by_torque * (torque - now->torque);
    now->torque = torque;
    return (Motion){current, final * ratio, 0.5 * step * ratio * (speed + final)};
}

static inline Memory by_network(Motion motion, const Resistance *load, const Mover *m, const Memory *last, Motion *after)
{
    const int brush = brush_of(m->train);
    const double ratio = m->train->p->motor.ratio, speed = motion.speed / ratio;
    const double *path = path_of(m->networks, brush ? brush : SLOW_BRUSH);
    const Sample before = {last->terminal, last->torque, last->current, last->speed};
    Sample now = {m->train->connection->terminal, last->torque, motion.current, speed};
    Memory none = {0.0, 0.0, 0.0, 0.0, NO_BRUSH, AT_STANDSTILL};
    if (brush == NO_BRUSH || speed < path[4]) return none;
    const double margin = last->mode == BY_NETWORK ? 0.0 : RETURN_MARGIN;
    if (last->brush != brush) {
        if (last->brush == NO_BRUSH && last->mode == OUTSIDE_TRAINING) none.mode = OUTSIDE_TRAINING;
        return none;
    }
    none.mode = OUTSIDE_TRAINING;
    if (margin > 0.0 && !within(path, &before, margin)) return none;
    *after = coupled(path, &now, &before, load, m->train);
    const Sample reached = {now.terminal, now.torque, after->current, after->speed / ratio};
    if (!(within(path, &now, margin) && within(path, &reached, 0.0))) return none;
    return (Memory){now.terminal, now.torque, now.current, now.speed, brush, BY_NETWORK};
}

static inline Memory remembered(Motion before, Motion after, double mode, const Mover *m)
{
    const Train *train = m->train;
    const Motor *motor = &train->p->motor;
    const Brush *brush = train->connection->brush;
    const double step = train->p->step, ratio = motor->ratio, turned = after.turned - before.turned;
    int which = brush_of(train);
    if (which == NO_BRUSH || after.speed <= 0.0) return (Memory){0.0, 0.0, 0.0, 0.0, NO_BRUSH, mode};
    const double flux = brush->inductance * (after.current - before.current);
    const double charge = (train->connection->terminal * step - brush->constant * turned - flux) / brush->resistance;
    const double momentum = motor->inertia * (after.speed - before.speed);
    const double dry = copysign(motor->coulomb, after.speed) * step;
    const double impulse = brush->constant * charge - motor->damping * turned - momentum - dry;
    const Sample s = {train->connection->terminal, impulse / step * ratio, before.current, before.speed / ratio};
    if (!within(path_of(m->networks, which), &s, 0.0)) which = NO_BRUSH;
    return (Memory){s.terminal, s.torque, s.current, s.speed, which, mode};
}

static inline void step_whole(Whole *whole, Inputs in, const Parameters *p, Mover *m, const Table *table, double *out)
{
    State *state = &whole->plant;
    if (!(spoilt_state(state) + spoilt_inputs(&in) == 0.0 && state->guard == 0.0)) {
        make_safe(state, &in);
        whole->memory = (Memory){0};
        whole->load_mode = 0.0;
    }
    const double angle = state->angle, speed = state->speed / p->motor.ratio;
    const Contact contact = contact_now(state, &p->park_switch);
    const double phase = next_phase(&in, &p->park_switch, contact, state);
    const Connection connection = connect_motor(&in, p, contact, phase, state);
    const Motion start = {connection.closed ? state->current : 0.0, state->speed, 0.0};
    const Train train = {&connection, table, &in, p};
    m->train = &train;
    m->load_mode = p->load.model == NETWORK_LOAD ? load_in_charge(m->networks, speed, &in, whole->load_mode) : BY_PHYSICS;
    if (m->load_mode == BY_NETWORK) m->tangent = network_torque(m->networks, angle, speed, in.screen > 0.5);
    const Place at = find(table, angle);
    const Resistance load = resist_as(m, &at, angle, speed);
    measure(start, &at, &load, contact.shown, state, &train, out);
    Memory memory = {0};
    Motion end = start;
    if (m->motor_network) memory = by_network(start, &load, m, &whole->memory, &end);
    if (memory.mode != BY_NETWORK) {
        end = turn_whole(start, angle, &load, m);
        if (m->motor_network) memory = remembered(start, end, memory.mode, m);
    }
    out[KNOWN_OUTPUTS] = m->load_mode;
    out[KNOWN_OUTPUTS + 1] = memory.mode;
    *state = (State){without_denormals(end.current), without_denormals(end.speed),
                     within_turn(angle + end.turned / p->motor.ratio), contact.closed, contact.bounce_left, state->guard,
                     phase};
    whole->memory = memory;
    whole->load_mode = m->load_mode;
    if (spoilt_state(state) == 0.0 && state->guard == 0.0) return;
    state->current = state->speed = 0.0;
    state->angle = angle;
    state->guard = 1.0;
    whole->memory = (Memory){0};
    whole->load_mode = 0.0;
}

void simulate_networks(double *state, const double *inputs, const double *parameters, const double *table,
                       double *outputs, const Shape *shape)
{
    Parameters p;
    Whole whole;
    Inputs in;
    const Table curves = {table, shape->knots, shape->channels};
    Mover mover = {.networks = parameters + PARAMETERS, .motor_network = parameters[MOTOR_MODEL_AT] == 1.0};
    memcpy(&p, parameters, sizeof p);
    memcpy(&whole, state, sizeof whole);
    for (long tick = 0; tick < shape->ticks; ++tick) {
        memcpy(&in, inputs + tick * shape->input_width, sizeof in);
        step_whole(&whole, in, &p, &mover, &curves, outputs + tick * shape->output_width);
    }
    memcpy(state, &whole, sizeof whole);
}
