#include "tandem/math/tridiagonal.h"
