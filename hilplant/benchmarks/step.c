/* The whole step of the plant by hand, in C99: the yardstick for the compiled Python in hilplant/models.
 *
 * Rows as hilplant/models/records.py packs them; equations, order and names as in hilplant/models/plant.py, where
 * they are explained. Kept equal to it by tests/oracle/test_plant_in_c.py; nothing else uses it.
 */
#include <math.h>

#define TURN 6.283185307179586476925
enum { STATES = 6, INPUTS = 6, OUTPUTS = 17, STRETCHES = 24, SEARCH_CAP = 80 };
static const double SEARCH_TOLERANCE = 1e-14;

typedef struct { double resistance, inductance, constant; } Brush;
typedef struct {
    double step;
    Brush slow, fast;
    double inertia, damping, coulomb, ratio;
    double park_angle, half_window, hysteresis, bounce_ticks;
    double load, c1, c2;
    double left_offset, left_length, right_offset, right_length;
} Parameters;
typedef struct { double current, speed, angle, contact, bounce_left, guard; } State;
typedef struct { double relay_on, relay_fast, supply, screen, vehicle_speed, brake; } Inputs;
typedef struct { double current, speed, turned; } Motion;
typedef struct { double voltage, resistance, inductance, constant, inertia, damping, dry; } Drive;

static inline Motion glide(Motion motion, const Drive *drive, double torque, double time)
{
    const double a11 = -drive->resistance / drive->inductance, a12 = -drive->constant / drive->inductance;
    const double a21 = drive->constant / drive->inertia, a22 = -drive->damping / drive->inertia;
    const double mean = 0.5 * (a11 + a22), half = 0.5 * (a11 - a22);
    const double discriminant = half * half + a12 * a21, s = sqrt(fabs(discriminant));
    double shift, one, f;
    if (discriminant > 0.0) {
        shift = (a11 * a22 - a12 * a21) / (mean - s);
        one = exp(shift * time);
        f = one * (-expm1(-2.0 * s * time) / (2.0 * s));
    } else {
        shift = mean;
        f = exp(mean * time);
        one = f * cos(s * time);
        f *= s > 0.0 ? sin(s * time) / s : time;
    }
    const double strength = drive->resistance * drive->damping + drive->constant * drive->constant;
    const double final_current = (drive->voltage * drive->damping + drive->constant * torque) / strength;
    const double final_speed = (drive->voltage * drive->constant - drive->resistance * torque) / strength;
    const double i = motion.current - final_current, w = motion.speed - final_speed;
    Motion end;
    end.current = final_current + (one + f * (a11 - shift)) * i + f * a12 * w;
    end.speed = final_speed + f * a21 * i + (one + f * (a22 - shift)) * w;
    const double flux = drive->constant * drive->inductance * (end.current - motion.current);
    const double momentum = drive->resistance * drive->inertia * (end.speed - motion.speed);
    end.turned = motion.turned + final_speed * time - (flux + momentum) / strength;
    return end;
}

static inline double acceleration(Motion motion, const Drive *drive, double torque)
{
    return (drive->constant * motion.current - drive->damping * motion.speed - torque) / drive->inertia;
}

static double held_current(double current, const Drive *drive, double time)
{
    const double final = drive->voltage / drive->resistance;
    return final + (current - final) * exp(-time * drive->resistance / drive->inductance);
}

static double stick(Motion *motion, const Drive *drive, double left)
{
    const double final = drive->voltage / drive->resistance;
    const double threshold = copysign(drive->dry / drive->constant, final);
    motion->speed = 0.0;
    if (fabs(final) > fabs(threshold)) {
        const double ratio = (final - motion->current) / (final - threshold);
        const double wait = ratio > 1.0 ? log(ratio) * drive->inductance / drive->resistance : 0.0;
        if (wait < left) {
            motion->current = threshold * (1.0 + 1e-15);
            return wait;
        }
    }
    motion->current = held_current(motion->current, drive, left);
    return left;
}

static int dips(Motion start, Motion end, const Drive *drive, double sign)
{
    const double dry = drive->dry, voltage = drive->voltage - drive->constant * start.speed;
    if (sign * voltage * drive->constant > drive->resistance * dry && sign * drive->constant * start.current > dry)
        return 0;
    return sign * acceleration(start, drive, sign * dry) < 0.0 && sign * acceleration(end, drive, sign * dry) > 0.0;
}

static double half_period(const Drive *drive)
{
    const double half = 0.5 * (drive->resistance / drive->inductance - drive->damping / drive->inertia);
    const double discriminant
        = half * half - drive->constant * drive->constant / (drive->inductance * drive->inertia);
    return discriminant < 0.0 ? 0.5 * TURN / sqrt(-discriminant) : INFINITY;
}

static double instant_below_zero(Motion motion, const Drive *drive, double sign, double stretch)
{
    double low = 0.0, high = stretch;
    for (int k = 0; k < SEARCH_CAP && high - low > SEARCH_TOLERANCE * stretch; ++k) {
        const double middle = 0.5 * (low + high);
        const Motion point = glide(motion, drive, sign * drive->dry, middle);
        if (sign * point.speed < 0.0) return middle;
        if (sign * acceleration(point, drive, sign * drive->dry) < 0.0) low = middle;
        else high = middle;
    }
    return 0.0;
}

static double instant_of_zero(Motion motion, const Drive *drive, double sign, double below)
{
    const double torque = sign * drive->dry;
    double low = 0.0, high = below, instant = 0.5 * below;
    for (int k = 0; k < SEARCH_CAP; ++k) {
        const Motion point = glide(motion, drive, torque, instant);
        if (sign * point.speed > 0.0) low = instant;
        else high = instant;
        double following = instant - point.speed / acceleration(point, drive, torque);
        if (!(low <= following && following <= high)) following = 0.5 * (low + high);
        if (fabs(following - instant) <= SEARCH_TOLERANCE * below) return following;
        instant = following;
    }
    return instant;
}

static double slide(Motion *motion, const Drive *drive, double stretch)
{
    const double sign = copysign(1.0, motion->speed != 0.0 ? motion->speed : motion->current);
    const double torque = sign * drive->dry;
    const Motion end = glide(*motion, drive, torque, stretch);
    double below = stretch;
    if (sign * end.speed >= 0.0) {
        below = dips(*motion, end, drive, sign) ? instant_below_zero(*motion, drive, sign, stretch) : 0.0;
        if (below == 0.0) {
            *motion = end;
            return stretch;
        }
    }
    const double instant = instant_of_zero(*motion, drive, sign, below);
    *motion = glide(*motion, drive, torque, instant);
    motion->speed = 0.0;
    return instant;
}

static Motion advance(Motion motion, const Drive *drive, double duration)
{
    if (drive->dry == 0.0) return glide(motion, drive, 0.0, duration);
    double left = duration;
    for (int k = 0, swings = 0; k < STRETCHES; ++k) {
        if (motion.speed == 0.0 && fabs(drive->constant * motion.current) <= drive->dry)
            left -= stick(&motion, drive, left);
        else
            left -= slide(&motion, drive, swings < 2 ? fmin(left, half_period(drive)) : left);
        swings = motion.speed != 0.0 ? swings + 1 : 0;
        if (left <= 0.0) return motion;
    }
    motion.current = held_current(motion.current, drive, left);
    motion.speed = 0.0;
    return motion;
}

static inline double load_damping(double angle, double speed, const Parameters *p)
{
    if (p->load != 1.0) return 0.0;
    const double x = sin(angle);
    double shape;
    if (x >= 0.0) {
        shape = (((-0.19224 * x + 0.021769) * x - 0.15435) * x + 0.077812) * x + 0.68626;
    } else {
        shape = ((0.4184 * x - 0.30315) * x - 0.42441) * x + 0.12634;
        shape = (((shape * x + 0.21484) * x - 0.10093) * x - 0.29859) * x + 0.63276;
    }
    const double damping = p->c2 * (shape + speed * p->c1);
    return damping > 0.0 ? damping : 0.0;
}

static inline void hermite(const double *knots, long count, double angle, double *value, double *slope)
{
    const long intervals = count - 1;
    double place = angle * (intervals / TURN);
    if (!(0.0 <= place && place < intervals)) place = 0.0;
    const long index = (long)place;
    const double u = place - index, width = TURN / intervals;
    const double *knot = knots + 2 * index;
    const double m0 = knot[1] * width, m1 = knot[3] * width, rise = knot[2] - knot[0];
    const double c2 = 3.0 * rise - 2.0 * m0 - m1, c3 = m0 + m1 - 2.0 * rise;
    *value = knot[0] + u * (m0 + u * (c2 + u * c3));
    *slope = (m0 + u * (2.0 * c2 + u * (3.0 * c3))) / width;
}

static inline double finite_or_0(double value) { return isfinite(value) ? value : 0.0; }

static inline double zero_if_finite(double a, double b, double c) { return 0.0 * a + 0.0 * b + 0.0 * c; }

static inline void admit(State *state, Inputs *in)
{
    const double zero = zero_if_finite(state->current, state->speed, state->angle)
        + zero_if_finite(in->relay_on, in->relay_fast, in->supply)
        + zero_if_finite(in->screen, in->vehicle_speed, in->brake);
    if (zero == 0.0 && state->guard == 0.0) return;
    *state = (State){0.0, 0.0, finite_or_0(state->angle), finite_or_0(state->contact),
                     finite_or_0(state->bounce_left), 1.0};
    *in = (Inputs){0.0, 0.0, finite_or_0(in->supply), finite_or_0(in->screen), finite_or_0(in->vehicle_speed), 0.0};
}

static inline double park_contact(State *state, const Parameters *p)
{
    double distance = fabs(state->angle - p->park_angle);
    distance = fmin(distance, fabs(TURN - distance));
    const double reach = p->half_window + (state->contact > 0.5 ? p->hysteresis : 0.0);
    const double closed = distance <= reach ? 1.0 : 0.0;
    if (closed != state->contact) {
        state->bounce_left = p->bounce_ticks;
        return state->contact = closed;
    }
    if (state->bounce_left <= 0.0) {
        state->bounce_left = 0.0;
        return closed;
    }
    const int away = fmod(p->bounce_ticks - state->bounce_left, 2.0) < 1.0;
    state->bounce_left -= 1.0;
    return away ? 1.0 - closed : closed;
}

static inline double without_denormals(double value) { return fabs(value) < 1e-30 ? 0.0 : value; }

static inline double within_turn(double angle)
{
    if (0.0 <= angle && angle < TURN) return angle;
    const double wrapped = angle - TURN * floor(angle / TURN);
    return 0.0 <= wrapped && wrapped < TURN ? wrapped : wrapped * 0.0;
}

static inline void step(State *state, Inputs in, const Parameters *p, const double *tables, long knots, double *out)
{
    admit(state, &in);
    const double angle = state->angle, speed = state->speed / p->ratio;
    const Brush *brush = in.relay_fast > 0.5 ? &p->fast : &p->slow;
    const double terminal = in.relay_on > 0.5 ? in.supply : 0.0;
    const double contact = park_contact(state, p);
    double left, left_slope, right, right_slope;
    hermite(tables, knots, angle, &left, &left_slope);
    hermite(tables + 2 * knots, knots, angle, &right, &right_slope);
    double load = load_damping(angle, speed, p) * fabs(speed);
    if (speed != 0.0) load += in.brake;
    out[0] = in.supply;
    out[1] = terminal;
    out[2] = state->current;
    out[3] = state->speed;
    out[4] = speed;
    out[5] = angle;
    out[6] = load;
    out[7] = contact;
    out[8] = left + p->left_offset;
    out[9] = right + p->right_offset;
    out[10] = left;
    out[11] = right;
    out[12] = p->left_length * left_slope * speed;
    out[13] = p->right_length * right_slope * speed;
    out[14] = in.relay_on;
    out[15] = in.relay_fast;
    out[16] = state->guard;
    const double half_way = angle + 0.5 * p->step * speed;
    const Drive drive = {terminal, brush->resistance, brush->inductance, brush->constant, p->inertia,
                         p->damping + load_damping(half_way, speed, p) / (p->ratio * p->ratio),
                         p->coulomb + in.brake / p->ratio};
    const Motion end = advance((Motion){state->current, state->speed, 0.0}, &drive, p->step);
    state->current = without_denormals(end.current);
    state->speed = without_denormals(end.speed);
    state->angle = within_turn(angle + end.turned / p->ratio);
    if (zero_if_finite(state->current, state->speed, state->angle) != 0.0) {
        state->current = state->speed = 0.0;
        state->angle = angle;
        state->guard = 1.0;
    }
}

void simulate_rows(double *state_row, const double *inputs, long n, const double *parameter_row,
                   const double *tables, long knots, double *outputs)
{
    const double *r = parameter_row;
    const Parameters parameters = {r[0], {r[1], r[2], r[3]}, {r[4], r[5], r[6]}, r[7], r[8], r[9], r[10], r[11], r[12],
                                   r[13], r[14], r[15], r[16], r[17], r[18], r[19], r[20], r[21]};
    State state = {state_row[0], state_row[1], state_row[2], state_row[3], state_row[4], state_row[5]};
    for (long k = 0; k < n; ++k) {
        const double *in = inputs + k * INPUTS;
        step(&state, (Inputs){in[0], in[1], in[2], in[3], in[4], in[5]}, &parameters, tables, knots,
             outputs + k * OUTPUTS);
    }
    const double end[STATES] = {state.current, state.speed, state.angle, state.contact, state.bounce_left, state.guard};
    for (int k = 0; k < STATES; ++k) state_row[k] = end[k];
}
