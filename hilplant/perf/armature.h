/* Armature and motor: closed-form motion, and standing still as an event; models/armature.py, models/motor.py. */
#ifndef HILPLANT_ARMATURE_H
#define HILPLANT_ARMATURE_H

#include "records.h"

enum { MOTOR_STRETCHES = 24, SEARCH_CAP = 80 };
static const double SEARCH_TOLERANCE = 1e-14;

typedef struct { double current, speed, turned; } Motion;
typedef struct { double voltage, resistance, inductance, constant, inertia, damping, dry; } Drive;
typedef struct { double forwards, backwards; } Hold;

static inline Motion coast(Motion motion, const Drive *drive, double torque, double time)
{
    const double x = drive->damping * time / drive->inertia;
    double first, second;
    if (x < 1e-3) {
        first = 1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0));
        second = 0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0));
    } else {
        first = -expm1(-x) / x;
        second = (1.0 - first) / x;
    }
    const double change = -(drive->damping * motion.speed + torque) / drive->inertia * time;
    return (Motion){0.0, motion.speed + change * first, motion.turned + time * (motion.speed + change * second)};
}

static inline Motion glide(Motion motion, const Drive *drive, double torque, double time)
{
    if (drive->constant == 0.0) return coast(motion, drive, torque, time);
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

static inline double direction_of(Motion motion, const Drive *drive, Hold hold)
{
    if (motion.speed != 0.0) return copysign(1.0, motion.speed);
    const double torque = drive->constant * motion.current;
    if (torque > hold.forwards) return 1.0;
    return -torque > hold.backwards ? -1.0 : 0.0;
}

static inline Motion stand(Motion motion, const Drive *drive, double time)
{
    if (drive->constant == 0.0) return (Motion){0.0, 0.0, motion.turned};
    const double final = drive->voltage / drive->resistance;
    const double current = final + (motion.current - final) * exp(-time * drive->resistance / drive->inductance);
    return (Motion){current, 0.0, motion.turned};
}

/* Each of the next two moves the motion on and returns the time that it took. */
static double stick(Motion *motion, const Drive *drive, Hold hold, double left)
{
    const double final = drive->voltage / drive->resistance, torque = drive->constant * final;
    if (torque > hold.forwards || -torque > hold.backwards) {
        const double held = torque > hold.forwards ? hold.forwards : -hold.backwards;
        const double threshold = held / drive->constant;
        const double ratio = (final - motion->current) / (final - threshold);
        const double wait = log(ratio > 1.0 ? ratio : 1.0) * drive->inductance / drive->resistance;
        if (wait < left) {
            motion->current = threshold + 1e-15 * (final - threshold + fabs(threshold) * copysign(1.0, torque));
            motion->speed = 0.0;
            return wait;
        }
    }
    *motion = stand(*motion, drive, left);
    return left;
}

static int dips(Motion start, Motion end, const Drive *drive, double sign)
{
    const double dry = drive->dry, voltage = drive->voltage - drive->constant * start.speed;
    if (sign * voltage * drive->constant > drive->resistance * dry && sign * drive->constant * start.current > dry)
        return 0;
    return sign * acceleration(start, drive, sign * dry) < 0.0 && sign * acceleration(end, drive, sign * dry) > 0.0;
}

static inline double half_period(const Drive *drive)
{
    const double half = 0.5 * (drive->resistance / drive->inductance - drive->damping / drive->inertia);
    const double discriminant
        = half * half - drive->constant * drive->constant / (drive->inductance * drive->inertia);
    return discriminant < 0.0 ? 0.5 * TURN / sqrt(-discriminant) : INFINITY;
}

static double instant_below_zero(Motion motion, const Drive *drive, double sign, double stretch)
{
    double low = 0.0, high = stretch;
    for (int k = 0; k < SEARCH_CAP; ++k) {
        const double middle = 0.5 * (low + high);
        const Motion point = glide(motion, drive, sign * drive->dry, middle);
        if (sign * point.speed < 0.0) return middle;
        if (sign * acceleration(point, drive, sign * drive->dry) < 0.0) low = middle;
        else high = middle;
        if (high - low <= SEARCH_TOLERANCE * stretch) break;
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

static inline double slide(Motion *motion, const Drive *drive, double sign, double stretch)
{
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

static inline Motion advance(Motion motion, const Drive *drive, double duration)
{
    if (drive->dry == 0.0) return glide(motion, drive, 0.0, duration);
    const Hold hold = {drive->dry, drive->dry};
    double left = duration;
    for (int k = 0, swings = 0; k < MOTOR_STRETCHES; ++k) {
        const double direction = direction_of(motion, drive, hold);
        if (direction == 0.0) left -= stick(&motion, drive, hold, left);
        else left -= slide(&motion, drive, direction, swings < 2 ? fmin(left, half_period(drive)) : left);
        swings = motion.speed != 0.0 ? swings + 1 : 0;
        if (left <= 0.0) return motion;
    }
    return stand(motion, drive, left);
}

#endif
