#include "tandem/math/so3.h"
