#include "tandem/collision/certificate.h"
