/* Park switch, its contacts, and the three circuits; models/park_switch.py, park_phase.py, wiring.py, circuit.py. */
#ifndef HILPLANT_CIRCUIT_H
#define HILPLANT_CIRCUIT_H

#include "records.h"

typedef struct { double closed, shown, bounce_left; } Contact;
typedef struct { double potential; int driven; } Lead;
typedef struct { Lead slow, fast, common, park; int joined; } Leads;
typedef struct { const Brush *brush; double terminal; int closed; double v53, v53b, v53e, v31; } Connection;

static inline Contact contact_now(const State *state, const ParkSwitch *park_switch)
{
    double distance = fabs(state->angle - park_switch->angle);
    const double other_way = fabs(TURN - distance);
    if (other_way < distance) distance = other_way;
    const double reach = park_switch->half_window + (state->contact > 0.5 ? park_switch->hysteresis : 0.0);
    const double closed = distance <= reach ? 1.0 : 0.0;
    if (closed != state->contact) return (Contact){closed, closed, park_switch->bounce_ticks};
    if (state->bounce_left <= 0.0) return (Contact){closed, closed, 0.0};
    const int away = fmod(park_switch->bounce_ticks - state->bounce_left, 2.0) < 1.0;
    return (Contact){closed, away ? 1.0 - closed : closed, state->bounce_left - 1.0};
}

static inline double turned_back(double angle, const ParkSwitch *park_switch)
{
    const double before = park_switch->angle - park_switch->half_window - angle;
    const double highest = 0.5 * (TURN + park_switch->reverse_angle) - park_switch->half_window;
    return before - TURN * ceil((before - highest) / TURN);
}

static inline double next_phase(const Inputs *in, const ParkSwitch *park_switch, Contact contact, const State *state)
{
    if (in->relay_on > 0.5 || park_switch->circuit != DEPRESSED) return WIPING;
    if (state->park_phase == WIPING) return contact.closed > 0.5 ? TURNING_BACK : WIPING;
    if (state->park_phase == TURNING_BACK && turned_back(state->angle, park_switch) < park_switch->reverse_angle)
        return TURNING_BACK;
    return PARKED;
}

static inline Leads digital(const Inputs *in)
{
    const Lead ground = {0.0, 1}, open = {0.0, 0}, on_off = {in->relay_on > 0.5 ? in->supply : 0.0, 1};
    if (in->relay_fast > 0.5) return (Leads){open, on_off, ground, open, 0};
    return (Leads){on_off, open, ground, open, 0};
}

static inline Leads mechanical(const Inputs *in, Contact contact)
{
    const Lead battery = {in->supply, 1}, ground = {0.0, 1}, open = {0.0, 0};
    Lead park = contact.closed > 0.5 ? ground : battery;
    if (contact.shown != contact.closed) park = open;
    if (!(in->relay_on > 0.5)) return (Leads){park, open, ground, park, 1};
    if (in->relay_fast > 0.5) return (Leads){open, battery, ground, park, 0};
    return (Leads){battery, open, ground, park, 0};
}

static inline Leads depressed(const Inputs *in, Contact contact, double phase)
{
    const Lead battery = {in->supply, 1}, ground = {0.0, 1}, open = {0.0, 0};
    const int on = in->relay_on > 0.5, fast = in->relay_fast > 0.5;
    const int bouncing = contact.closed > 0.5 && contact.shown != contact.closed;
    Lead contact_a = battery, contact_b = on ? open : ground;
    if (phase == TURNING_BACK) {
        contact_a = ground;
        contact_b = battery;
    }
    if (phase == PARKED || (phase == TURNING_BACK && bouncing)) contact_a = contact_b = open;
    if (!on) return (Leads){contact_b, open, contact_a, contact_b, 1};
    return (Leads){fast ? open : ground, fast ? ground : open, battery, contact_b, 0};
}

static inline Connection seen_by_armature(const Leads *leads, const Motor *motor, double polarity, double speed)
{
    const double common = leads->common.potential;
    double slow = leads->slow.potential, fast = leads->fast.potential;
    if (!leads->slow.driven) slow = common + polarity * motor->slow.constant * speed;
    if (!leads->fast.driven) fast = common + polarity * motor->fast.constant * speed;
    const double park = leads->joined ? slow : leads->park.potential;
    const int by_fast = leads->fast.driven, closed = (by_fast || leads->slow.driven) && leads->common.driven;
    const double terminal = closed ? polarity * ((by_fast ? fast : slow) - common) + 0.0 : 0.0;
    return (Connection){by_fast ? &motor->fast : &motor->slow, terminal, closed, slow, fast, park, common};
}

static inline Connection connect_motor(const Inputs *in, const Parameters *p, Contact contact, double phase,
                                       const State *state)
{
    const double circuit = p->park_switch.circuit;
    const Leads leads = circuit == MECHANICAL ? mechanical(in, contact)
                      : circuit == DEPRESSED  ? depressed(in, contact, phase)
                                              : digital(in);
    Connection connection = seen_by_armature(&leads, &p->motor, circuit == DEPRESSED ? -1.0 : 1.0, state->speed);
    if (state->guard > 0.5) {
        connection.terminal = 0.0;
        connection.closed = 0;
    }
    return connection;
}

#endif
