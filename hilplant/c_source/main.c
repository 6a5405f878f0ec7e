/* Steps the bench: rows of inputs on standard input, rows of outputs on standard output, numbers with commas between.
 *
 *     ./plant < inputs.csv > outputs.csv     until the inputs end
 *     ./plant 5000 > outputs.csv             5000 ticks, the bench's own inputs, switched on
 *
 * A line that does not begin with a number, such as one of names, is passed over.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"

static int read_inputs(double inputs[HILPLANT_INPUTS])
{
    char line[4096];
    while (fgets(line, sizeof line, stdin)) {
        char *at = line, *end = line;
        int count = 0;
        for (; count < HILPLANT_INPUTS; ++count, at = end + (*end == ',')) {
            inputs[count] = strtod(at, &end);
            if (end == at) break;
        }
        if (count == HILPLANT_INPUTS) return 1;
        if (count > 0) {
            fprintf(stderr, "a row has %d numbers, not %d: %s", count, HILPLANT_INPUTS, line);
            exit(1);
        }
    }
    return 0;
}

int main(int count, char **arguments)
{
    double state[HILPLANT_STATES], inputs[HILPLANT_INPUTS], outputs[HILPLANT_OUTPUTS];
    const long ticks = count > 1 ? strtol(arguments[1], NULL, 10) : -1;
    memcpy(state, bench_state, sizeof state);
    memcpy(inputs, bench_inputs, sizeof inputs);
    inputs[INPUT_RELAY_ON] = 1.0;
    puts("time_s," HILPLANT_OUTPUT_NAMES);
    for (long tick = 0; ticks < 0 ? read_inputs(inputs) : tick < ticks; ++tick) {
        hilplant_tick(&bench, state, inputs, outputs);
        printf("%.17g", (double)tick * BENCH_STEP_S);
        for (int k = 0; k < HILPLANT_OUTPUTS; ++k) printf(",%.17g", outputs[k]);
        putchar('\n');
    }
    return 0;
}
