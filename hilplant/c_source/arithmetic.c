/* Numbers as Python and numba reckon with them. */
static inline double smaller(double one, double other) { return other < one ? other : one; }

static inline double greater(double one, double other) { return other > one ? other : one; }

static inline int64_t smaller_integer(int64_t one, int64_t other) { return other < one ? other : one; }

static inline int64_t greater_integer(int64_t one, int64_t other) { return other > one ? other : one; }

/* The remainder has the sign of y. */
static inline double float_modulo(double x, double y)
{
    const double rest = fmod(x, y);
    if (y == 0.0) return rest;
    if (rest == 0.0) return y < 0.0 ? -0.0 : 0.0;
    return (y < 0.0) != (rest < 0.0) ? rest + y : rest;
}

static inline int64_t integer_modulo(int64_t x, int64_t y)
{
    const int64_t rest = x % y;
    return rest != 0 && (rest < 0) != (y < 0) ? rest + y : rest;
}
