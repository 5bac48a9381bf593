#include "tandem/trajectory/spline.h"
