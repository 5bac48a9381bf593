#include "tandem/geometry/shape.h"
