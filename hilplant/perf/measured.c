/* What is measured besides the step: many parameter sets on all processors, and the torque network alone. */

/* States [sets, states], inputs [ticks, inputs] of all sets, parameters [sets, parameters], outputs [sets, ticks,
 * columns], of which `columns` are the places; compiled with OpenMP on all processors. */
void simulate_batch(const hilplant_plant *plants, int64_t sets, double *states, int64_t ticks, const double *inputs,
                    int64_t column_count, const int64_t *columns, double *outputs)
{
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic)
#endif
    for (int64_t set = 0; set < sets; ++set) {
        double row[HILPLANT_OUTPUTS];
        simulate_columns((WritableArray_n){states + set * HILPLANT_STATES, {HILPLANT_STATES}},
                         (Array_nn){inputs, {ticks, HILPLANT_INPUTS}}, parameters_of(plants + set),
                         tables_of(plants + set), (Integers_n){columns, {column_count}},
                         (WritableArray_nn){outputs + set * ticks * column_count, {ticks, column_count}},
                         (WritableArray_n){row, {HILPLANT_OUTPUTS}});
    }
}

/* The network's torque and its derivatives [count, 3] at angles and speeds [count, 2]. */
void torque_tangents(const double *networks, int64_t length, int wet, const double *states, int64_t count,
                     double *tangents)
{
    network_tangents((Array_n){networks, {length}}, wet != 0, (Array_nn){states, {count, 2}},
                     (WritableArray_nn){tangents, {count, 3}});
}
