/* The torque network by hand, in C: the yardstick for hilplant/models/torque_network.py, where it is explained.
 *
 * Kept equal to it by tests/oracle/test_surrogates_torque_network.py; nothing else uses it.
 */
#include <math.h>

enum { NEURONS = 1, DRY = 5, WET = 6, FIRST = 7, NEURON = 9 };
typedef struct { double torque, by_angle, by_speed; } Tangent;

static inline Tangent tangent(const double *restrict numbers, double angle, double speed, int wet)
{
    const double s = sin(angle), c = cos(angle), s2 = 2.0 * s * c, c2 = 1.0 - 2.0 * s * s;
    const int column = wet ? 8 : 7, neurons = (int)numbers[NEURONS];
    Tangent at = { numbers[wet ? WET : DRY], 0.0, 0.0 };
    for (const double *n = numbers + FIRST, *end = n + NEURON * neurons; n < end; n += NEURON) {
        double bent = n[0] * angle + n[5] * speed + n[6];
        bent += n[1] * s + n[2] * c;
        bent += n[3] * s2 + n[4] * c2;
        const double turned = n[0] + n[1] * c - n[2] * s + 2.0 * (n[3] * c2 - n[4] * s2);
        const double share = 1.0 / (1.0 + exp(bent)), part = n[column] * share, slope = part * (share - 1.0);
        at.torque += part;
        at.by_angle += slope * turned;
        at.by_speed += slope * n[5];
    }
    return at;
}

/* states [m, 2]: angle and speed; tangents [m, 3]: torque and its derivatives by both. */
void network_tangents(const double *numbers, int wet, const double *states, long m, double *tangents)
{
    for (long row = 0; row < m; ++row) {
        const Tangent at = tangent(numbers, states[2 * row], states[2 * row + 1], wet);
        tangents[3 * row] = at.torque;
        tangents[3 * row + 1] = at.by_angle;
        tangents[3 * row + 2] = at.by_speed;
    }
}
