static Array_n parameters_of(const hilplant_plant *plant)
{
    return (Array_n){plant->parameters, {plant->parameter_count}};
}

static Array_nn2 tables_of(const hilplant_plant *plant)
{
    return (Array_nn2){plant->tables, {plant->knots, plant->channels}};
}

void hilplant_tick(const hilplant_plant *plant, double *state, const double *inputs, double *outputs)
{
    tick((WritableArray_n){state, {HILPLANT_STATES}}, (Array_n){inputs, {HILPLANT_INPUTS}}, parameters_of(plant),
         tables_of(plant), (WritableArray_n){outputs, {HILPLANT_OUTPUTS}});
}

void hilplant_simulate(const hilplant_plant *plant, double *state, int64_t ticks, const double *inputs, double *outputs)
{
    simulate_rows((WritableArray_n){state, {HILPLANT_STATES}}, (Array_nn){inputs, {ticks, HILPLANT_INPUTS}},
                  parameters_of(plant), tables_of(plant), (WritableArray_nn){outputs, {ticks, HILPLANT_OUTPUTS}});
}
