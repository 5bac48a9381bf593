#include "tandem/motion/piecewise_cubic.h"
