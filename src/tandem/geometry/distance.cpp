#include "tandem/geometry/distance.h"
